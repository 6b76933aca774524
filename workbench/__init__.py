"""The window: PySide6 views and presenters over `core`. No numbers are made here."""
