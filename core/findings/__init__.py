"""What can be known about a result: how grave it is, what it does to what rests on it, and the facts that say so."""
