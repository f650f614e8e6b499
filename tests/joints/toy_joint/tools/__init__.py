"""The toy joint, for the tools."""
