"""The three hunters of the paper: reactive, prediction and planning."""
