"""Main job (`build_fmus.py`): build and check all FMUs, compare them with the papers, write the report."""
