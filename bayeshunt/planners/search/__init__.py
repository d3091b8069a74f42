"""Search over gait sequences, and the sampled outcomes that it values: what the planning hunter is made of."""
