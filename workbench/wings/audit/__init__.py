"""The audit trail of the open project, and who has signed in."""
