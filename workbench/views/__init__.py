"""Widgets the pages are made of. They show core's results and know nothing of projects or steps."""
