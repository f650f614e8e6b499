"""The bodies of a whole joint reduced to modes, for `BoltedJoint` with elastic sides."""
