"""The report that opens in a browser: of the main job (`page`), and of one joint (`joint`)."""
