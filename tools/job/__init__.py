"""The main job: all FMUs built, checked, compared with the papers, and the report."""
