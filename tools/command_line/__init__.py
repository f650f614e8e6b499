"""What the commands of `jointfmu` share: parser, options, examples."""
