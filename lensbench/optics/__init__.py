"""Pure optics: surfaces, lens, wearer, gaze field. Numpy and scipy in, arrays out; no files, no pictures."""
