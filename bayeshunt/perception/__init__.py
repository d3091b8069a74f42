"""From what a world did to what the hunter believes: sensors observe, trackers turn observations into beliefs."""
