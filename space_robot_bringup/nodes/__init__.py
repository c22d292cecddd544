"""Entry points that run one node as a process of its own."""
