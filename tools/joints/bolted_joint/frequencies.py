"""The box specimen of Zhao 2018 (Table 3); its lengths fit the six frequencies at 9 kN."""

from ...fem.validation import MeasuredFrequencies

FREQUENCIES = MeasuredFrequencies(points="zhao2018_modes", assembly="box_specimen_by_frequency")
