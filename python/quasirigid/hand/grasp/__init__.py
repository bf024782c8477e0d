"""A hand that closes on a product and holds it."""
