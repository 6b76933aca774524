"""One wizard page a step: widgets in *_page.py, decisions in *_presenter.py. Pages never import each other."""
