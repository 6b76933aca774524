from core import processor as processor  # before any library of numbers, as in every program of ours
