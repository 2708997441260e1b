"""The keys of pygame as those of ImGui."""

from __future__ import annotations

import string

import pygame
from imgui_bundle import imgui

MODIFIERS = (
    (pygame.KMOD_CTRL, imgui.Key.mod_ctrl),
    (pygame.KMOD_SHIFT, imgui.Key.mod_shift),
    (pygame.KMOD_ALT, imgui.Key.mod_alt),
    (pygame.KMOD_META, imgui.Key.mod_super),
)

# Pairs of names, pygame's and ImGui's, that text fields and menus need.
_NAMES = {
    "TAB": "tab",
    "LEFT": "left_arrow",
    "RIGHT": "right_arrow",
    "UP": "up_arrow",
    "DOWN": "down_arrow",
    "PAGEUP": "page_up",
    "PAGEDOWN": "page_down",
    "HOME": "home",
    "END": "end",
    "INSERT": "insert",
    "DELETE": "delete",
    "BACKSPACE": "backspace",
    "SPACE": "space",
    "RETURN": "enter",
    "KP_ENTER": "keypad_enter",
    "ESCAPE": "escape",
    "LCTRL": "left_ctrl",
    "RCTRL": "right_ctrl",
    "LSHIFT": "left_shift",
    "RSHIFT": "right_shift",
    "LALT": "left_alt",
    "RALT": "right_alt",
    "LMETA": "left_super",
    "RMETA": "right_super",
    **{letter: letter for letter in string.ascii_lowercase},
    **{digit: f"_{digit}" for digit in string.digits},
}

KEYS: dict[int, imgui.Key] = {
    getattr(pygame, f"K_{ours}"): getattr(imgui.Key, theirs) for ours, theirs in _NAMES.items()
}
