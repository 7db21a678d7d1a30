"""The window: Qt only here. A document holds what lies on the table; panels and viewports show it and ask the lane."""
