#!/bin/sh
# Makes DejaVuSans.ttf from the full font (Debian package fonts-dejavu-core 2.37); needs fonttools' pyftsubset.
# Glyphs: Latin-1, Latin Extended-A, Greek, Cyrillic, dashes and quotes, super- and subscripts, arrows, mathematical signs.
# Kerning and other layout features are left out, so that the width of a text is the sum of its advances.
set -eu
pyftsubset "${1:-/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf}" \
  --output-file=DejaVuSans.ttf --no-hinting --notdef-outline --layout-features='' \
  --drop-tables+=GSUB,GPOS,GDEF,kern,MATH,gasp,FFTM,DSIG --name-IDs=0,1,2,4,5,6,13,14 \
  --unicodes=U+0020-007E,U+00A0-017F,U+0384-03CE,U+0400-045F,U+2009,U+200A,U+2010-2015,U+2018-201E,U+2020-2022,U+2026,U+202F,U+2030,U+2032,U+2033,U+2070-208E,U+2126,U+2190-2195,U+2202,U+2206,U+2207,U+2211,U+2212,U+221A,U+221E,U+2248,U+2260,U+2264,U+2265
