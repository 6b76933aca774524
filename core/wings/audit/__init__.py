"""The audit trail of a project: who changed what, who may, and whether all is what it was."""
