"""What carries an interface law into a joint: curve, friction, and the pressure over its area."""
