"""What trackers take for granted alike."""

from __future__ import annotations

__all__ = ["BODIES_PER_SECOND", "LEAST_RESULTANT", "SURE", "TOLERANCE"]

#: Share of a time-step by which the time between two sightings may be off for their transition to count as one step's.
TOLERANCE = 0.1
#: A mean heading of a resultant below this is noise: the prey is then taken to go away from the hunter.
LEAST_RESULTANT = 0.3
#: Both headings of a transition must be this sure for it to count.
SURE = 0.9
#: A prey whose motion is quite unknown goes so many body lengths per second.
BODIES_PER_SECOND = 0.9
