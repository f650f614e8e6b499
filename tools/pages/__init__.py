"""HTML pages: report and laboratory."""
