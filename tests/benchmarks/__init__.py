"""How fast it is: `make bench`. Each benchmark prints ratios within one run; none is part of `make test`."""
