"""How results are shown: tables, figures, pages, reports, golden files and FE decks. None knows the command line.

Neighbours use: `tables` (text, Markdown, JSON, CSV), `figures` (studies as figures) on `drawing` (figures as SVG or
letters), `machine_geometry`, `web_page`, `client_report`, `snapshots` (what of a run is kept and compared), `fe_decks`.
"""
