"""What linked firmware is: code, RAM, call graph, doubles. Plain Python and the cross compiler's binutils."""
