"""What no hunter can beat, or only by luck: the kinematic limit, the omniscient and the reference hunter."""
