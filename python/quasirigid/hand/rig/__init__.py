"""The joints of a hand: names, frames and turns."""
