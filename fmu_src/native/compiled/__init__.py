"""C compiled for five platforms: the compiler, parts that FMUs share, and what is put into them."""
