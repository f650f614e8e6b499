"""The proof that an FMU carries: files of FMI-LS-REF, and model exchange as their reference."""
