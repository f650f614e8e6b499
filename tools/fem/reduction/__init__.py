"""Modal reduction of the bodies of a bolted joint, for `BoltedJoint` with elastic sides."""
