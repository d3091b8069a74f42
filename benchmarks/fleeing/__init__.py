"""Prey that learned to flee: trained by PPO against each of our hunters, and every hunter against each of them."""
