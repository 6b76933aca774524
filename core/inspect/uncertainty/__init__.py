"""What errs in measured points, and the expanded uncertainty that follows."""
