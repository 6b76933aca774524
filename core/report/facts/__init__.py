"""What is told of each result, made once: terminal, window, PDF, XLSX and CSV draw these lists."""
