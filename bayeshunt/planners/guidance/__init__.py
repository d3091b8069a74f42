"""Classical guidance, which a learned hunter has to beat: pursuit, proportional navigation, a Kalman filter."""
