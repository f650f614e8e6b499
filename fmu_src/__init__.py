"""FMUs of jointfmu: the list of variables, the builders and what runs inside."""
