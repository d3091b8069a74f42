"""The hunter that goes round what stands in its way, on a map of free space that it has learned."""
