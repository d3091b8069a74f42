/* The page of a network. */
const network = new NetworkView(document.getElementById("place"), JSON.parse(document.getElementById("data").textContent));
