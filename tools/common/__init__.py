"""Helpers of all tools: tables, plots, display, judgement of a stiffness, tool modules of the joints."""
