"""Command-line tools shared by all commands of `jointfmu`: parser, options, outputs, examples."""
