"""What a learned slip detector is worth in the published loop, and how many trials it takes."""
