"""What every command shares: exit codes, progress, outputs, text that is safe to print."""
