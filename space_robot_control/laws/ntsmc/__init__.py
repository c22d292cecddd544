"""Non-singular terminal sliding mode control of Giordano, Cenedese 2023, and its Euler-angle baseline."""
