// What the page may ask, said before anything else of it is loaded: its own address, and print hosts that the user has entered.
{
  const origins = JSON.parse(localStorage.getItem("print-hosts") ?? "[]").map(({ url }) => new URL(url).origin);
  const policy = document.createElement("meta");
  policy.httpEquiv = "Content-Security-Policy";
  policy.content = `connect-src 'self' ${[...new Set(origins)].join(" ")}`;
  document.head.append(policy);
}
