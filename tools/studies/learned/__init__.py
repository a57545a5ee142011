"""The value of a learned slip detector in the published loop, and the number of trials that it needs."""
