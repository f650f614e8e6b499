"""Reports as HTML pages: of all joints, from `python build_fmus.py` (`page`), and of one joint (`joint`)."""
