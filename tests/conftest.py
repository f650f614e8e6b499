"""Random cases are the same in every run, so a failure can be replayed."""

from hypothesis import settings

settings.register_profile("jointfmu", deadline=None, max_examples=100, derandomize=True)
settings.load_profile("jointfmu")
