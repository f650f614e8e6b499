"""Published numbers beside the computed ones, and what is calibrated to them."""
