"""The colors of all pictures; without matplotlib, which interactive pages need not wait for."""

# Okabe and Ito: distinguishable for colour-blind readers, also in print.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#6B5B95", "#7F7F7F")
