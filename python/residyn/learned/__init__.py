"""What the compensator of a trained model learned, for many arms at once: in NumPy, or in torch on any device."""

from .model import Learned

__all__ = ["Learned"]
