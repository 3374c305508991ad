"""Scripts that draw the pictures of the documents from the documents' own tables."""
