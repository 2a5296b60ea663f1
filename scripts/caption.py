"""Writes the time and a scale bar under pictures whose scale is the same all over."""
import math

from PIL import Image, ImageDraw, ImageFont

PREFIXES = ((1, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm"))


def bar_length(most):
    """Returns the largest of 1, 2, 5, 10, ... that is no more."""
    power = 10.0 ** math.floor(math.log10(most))
    return max(power * digit for digit in (1, 2, 5) if power * digit <= most * (1 + 1e-9))


def unit_for(length, unit):
    """Returns how large a unit is in which a length has few digits, and its name: 1e-3 and "mm" for 0.005 m; others than metres are kept."""
    if unit != "m":
        return 1, unit or "cells"
    return next((p for p in PREFIXES if length >= p[0] * 0.999), PREFIXES[-1])


def length_text(length, unit):
    """Returns "5 mm" for 0.005 m."""
    size, name = unit_for(length, unit)
    return f"{length / size:.3g} {name}"


def captioned(image, text, pixels_a_length, unit):
    """Returns the picture with a strip under it: the text to the left, a bar of some length to the right."""
    from matplotlib import font_manager  # slow to import, and not for --help
    letter = max(12, round(min(image.size[0] / 26, math.sqrt(image.size[0] * image.size[1]) / 18)))
    strip = 2 * letter
    whole = Image.new("RGB", (image.size[0], image.size[1] + strip), "white")
    whole.paste(image, (0, 0))
    pen, font = ImageDraw.Draw(whole), ImageFont.truetype(font_manager.findfont("DejaVu Sans"), letter)
    middle, edge = image.size[1] + strip // 2, letter // 2
    pen.text((edge, middle), text, fill="black", font=font, anchor="lm")
    length = bar_length(0.25 * image.size[0] / pixels_a_length)
    label = length_text(length, unit)
    right = image.size[0] - edge - pen.textlength(label, font=font) - edge
    left = right - length * pixels_a_length
    pen.line([(left, middle), (right, middle)], fill="black", width=max(1, letter // 8))
    for end in (left, right):
        pen.line([(end, middle - letter // 4), (end, middle + letter // 4)], fill="black", width=max(1, letter // 8))
    pen.text((right + edge, middle), label, fill="black", font=font, anchor="lm")
    return whole
