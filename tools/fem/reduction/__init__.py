"""Modal reduction of the elastic bodies of a bolted joint, for `BoltedJoint` with elastic sides."""
