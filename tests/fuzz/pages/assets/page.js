a page
