"""A reflectance at every texel from pictures under known light: batched, resumable, with standard errors."""
