"""The commands of `jointfmu`, one module each: `add(commands)` declares it, the rest does it."""
