/* The page of a table being learned. */
learningView(document.getElementById("place"), JSON.parse(document.getElementById("data").textContent));
